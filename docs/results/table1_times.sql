-- gapath experiment=table1
-- Medians over the trials whose runs table1.csv has one by one.
select map, preset, round(1000 * median(plan_time_s), 4) as ms
from trials where experiment = 'table1' group by map, preset order by map, preset
