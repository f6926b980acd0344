-- gapath experiment=classes
select key, code, map, map_instance as instance, preset, count(*) as trials, sum(feasible::int) as found,
  quantile_cont(epochs, 0.5) filter (feasible) as epochs
from trials where experiment = 'classes'
group by key, code, map, map_instance, preset order by map, map_instance, preset
