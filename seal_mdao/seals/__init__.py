"""Definition, analysis and results of seals; the door seal of the paper."""
