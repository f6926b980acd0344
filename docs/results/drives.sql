-- gapath experiment=drives, and experiment=drives_enclosed and experiment=s04_drives
-- Steps and calls: medians and means; steps_ratio: steps / shortest of the drives that reached the target.
select key, code, map, preset, count(*) as drives, sum(reached::int) as reached,
  count(*) filter (outcome = 'returned') as returned, median(steps) as steps,
  round(median(steps_ratio), 5) as steps_ratio, min(shortest_steps) as shortest,
  mean(calls_a) as calls_a, mean(calls_b) as calls_b, mean(calls_c) as calls_c
from trials where experiment = 'drives'
group by key, code, map, preset order by map, preset
