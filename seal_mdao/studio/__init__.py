"""Live section: a local page on which a seal is changed by dragging (``seal-mdao studio``)."""
