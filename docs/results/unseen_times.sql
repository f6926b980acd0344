-- GAPATH_DATA=DATA make unseen
-- Of the trials whose runs unseen.csv has. expected_ms: of all trials for each that found a path; times: over A*'s on that map, of the family's rules.
select map_source as family, if(map.path like '%/map.yaml', split_part(map.path, '/', -2), parse_filename(map.path, true)) as map, preset, sum(feasible::int) as found,
  round(1000 * sum(plan_time_s), 4) as ms_of_all,
  round(1000 * sum(plan_time_s) / nullif(sum(feasible::int), 0), 6) as expected_ms,
  round(expected_ms / max(case when preset in ('astar', 'astar_length', 'inflated_astar')
    then 1000 * sum(plan_time_s) / sum(feasible::int) end) over (partition by map.path), 5) as times
from trials where experiment = 'unseen'
group by map_source, map.path, preset order by family, map, preset
