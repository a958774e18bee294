"""Export of results: tables (CSV), ParaView (VTU), Abaqus input files."""
