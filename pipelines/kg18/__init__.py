"""Tables and figures of KG18's known maps."""
