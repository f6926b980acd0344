-- gapath -m map=m22_scene01,...,m22_scene10 planner=visibility_ga planner.ga2_profile=v64,v67,v69 trials=100 name=m22_readings recorder=none, and with planner.genes=obstacles_and_ends
select key, code, map, planner.ga2_profile as profile, planner.genes as genes, count(*) as trials, sum(feasible::int) as found
from trials where experiment = 'm22_readings' group by all order by profile, genes, map
