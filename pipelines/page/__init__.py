"""How a page is made: sections, figures, templates."""
