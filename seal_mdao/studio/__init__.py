"""Live section: a page in the browser on which a seal is changed by dragging (``seal-mdao
studio``)."""
