-- GAPATH_DATA=DATA make unseen
-- longer: median of a path's octile length over the published, less 1; as_published: trials where it is that to six digits.
select map_source as family, if(map.path like '%/map.yaml', split_part(map.path, '/', -2), parse_filename(map.path, true)) as map, preset, count(distinct key) as problems,
  count(*) as trials, sum(feasible::int) as found, median(epochs) as epochs, round(median(length_ratio) - 1, 7) as longer,
  count(*) filter (abs(length_ratio - 1) < 0.000005) as as_published,
  string_agg(distinct code, ' ') as codes, string_agg(distinct key, ' ' order by key) as keys
from trials where experiment = 'unseen'
group by map_source, map.path, preset order by family, map, preset
