-- gapath experiment=field, and with GAPATH_DATA=DATA make field
-- Of the problems that have a way. length: of the lines of paths found, over the published least.
select key, code, map_source as family, map, map_instance as instance, width, height, preset, count(*) as problems,
  sum(feasible::int) as found, round(1000 * sum(plan_time_s), 4) as ms_of_all, round(1000000 * median(plan_time_s), 2) as us,
  round(avg(optimality_ratio), 5) as cost_ratio, round(quantile_cont(optimality_ratio, 0.99), 5) as cost_ratio_p99,
  round(avg(line_length / nullif(published_length, 0)) filter (feasible), 4) as length, round(max(line_length / nullif(published_length, 0)) filter (feasible), 4) as longest
from trials where experiment = 'field' and optimal_cost is not null
group by key, code, map_source, map, map_instance, width, height, preset order by map_source, map, map_instance, width, preset
