"""From a formulation to its solutions."""
