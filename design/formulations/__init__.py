"""Problems as data: what is to be solved, by whom is not said."""
