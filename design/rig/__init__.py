"""The crane on which every claim is shown: a machine whose motion is integrated, not assumed."""
