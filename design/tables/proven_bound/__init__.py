"""A proven bound of the residual that times between the rows of a table leave."""
