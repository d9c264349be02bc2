"""How the manual becomes a site: links, navigation, formulas, and the pages that are made from the declarations."""
