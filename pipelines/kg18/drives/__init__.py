"""Tables and figures of KG18's drives."""
