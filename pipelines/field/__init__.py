"""Tables and figures of many problems on a map, as people hold planners against each other."""
