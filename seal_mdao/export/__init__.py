"""Results for other programs: tables (CSV), ParaView (VTU)."""
