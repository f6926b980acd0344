-- gapath -m map=m22_scene01 map.obstacles=10,20,100 'map.number=range(1,6)' planner=visibility_ga,visibility_ga_unlimited planner.genes=obstacles,6 trials=20 name=m22_obstacles recorder=none
select key, code, map.obstacles as obstacles, map.number as number, preset, planner.genes as genes, count(*) as trials, sum(feasible::int) as found
from trials where experiment = 'm22_obstacles' group by all order by map.obstacles, preset, planner.genes, number
