"""Live shaping as blocks for controllers, which solve each change anew."""
