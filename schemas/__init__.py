"""Wire models: requests and answers of the service, with units and limits. No computation."""
