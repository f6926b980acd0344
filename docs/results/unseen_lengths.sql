-- GAPATH_DATA=DATA make unseen
-- Of all paths found on MovingAI's maps, whose runs unseen.csv has map by map.
select preset, sum(feasible::int) as found, round(median(length_ratio) - 1, 7) as longer
from trials where experiment = 'unseen' and map_source = 'movingai' group by preset order by preset
