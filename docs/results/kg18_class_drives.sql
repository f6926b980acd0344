-- gapath -m task=drive map=kg18_map1,kg18_map2,kg18_map3,kg18_map4,kg18_enclosed 'map.instance=range(0,30)' navigator=kg18 trials=4 name=kg18_class_drives recorder=none
select key, code, map, map.instance as instance, count(*) as drives, sum(reached::int) as reached, count(*) filter (outcome = 'returned') as returned,
  sum(steps_ratio) filter (reached) as ratios
from trials where experiment = 'kg18_class_drives' group by key, code, map, instance order by map, instance
