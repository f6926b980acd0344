-- GAPATH_DATA=DATA make unseen
-- steps_ratio: steps / shortest, median and most; ms: medians.
select key, code, parse_filename(map.path, true) as map, coalesce(map.inflation, 0) as inflation, drive.known_map is not null as known, preset, count(*) as drives,
  sum(reached::int) as reached, round(median(steps_ratio), 5) as steps_ratio, round(max(steps_ratio), 5) as most, min(shortest_steps) as shortest,
  round(1000 * median(compute_time_s), 4) as ms
from trials where experiment = 'real_drives'
group by all order by map, inflation, known, preset
