-- gapath -m task=drive map=kg18_map4 'map.instance=range(0,30)' navigator=sedighi trials=2 name=s04_class_drives recorder=none, and of map=kg18_map1,kg18_map2 trials=20 with corner_cutting=no_diagonals
select key, code, map, map.instance as instance, corner_cutting, count(*) as drives, sum(reached::int) as reached, round(median(steps_ratio), 4) as steps_ratio
from trials where experiment = 's04_class_drives' group by key, code, map, instance, corner_cutting order by map, instance, corner_cutting
