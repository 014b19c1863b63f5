"""What the service withstands: `make chaos`.

Each part starts a service of its own, does something bad to it, and holds what its clients see
against what the product promises.
"""
