"""Wire models: what enters and leaves the service, with units and limits. No computation."""
