-- gapath experiment=m22 and experiment=m22_concave
-- f, above and worst: the mean length of a path's straight lines in pixels, how much more than the shortest of its graph, in the mean and at most; shortest: how many had that.
with every as (
  select *, case when preset like '%corners' then 'corners' when preset like '%resized' then 'resized'
    when preset like 'visibility%' then 'axes' end as graph
  from trials where experiment in ('m22', 'm22_concave')),
least as (
  select experiment, map, graph, min(line_length) as least from every
  where preset in ('visibility_dijkstra', 'visibility_dijkstra_corners') group by all)
select key, code, experiment, map, preset, count(*) as trials, sum(feasible::int) as found,
  round(mean(line_length) filter (feasible), 5) as f,
  round(mean(line_length / least - 1) filter (feasible), 7) as above,
  round(max(line_length / least - 1) filter (feasible), 7) as worst,
  count(*) filter (feasible and line_length <= least) as shortest,
  round(mean(length) filter (feasible), 5) as octile, mean(epochs) as generations
from every left join least using (experiment, map, graph)
group by key, code, experiment, map, preset order by experiment, map, preset
