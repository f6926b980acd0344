-- gapath experiment=drives, and experiment=drives_enclosed and experiment=s04_drives
-- Medians over the drives whose runs drives.csv has one by one.
select map, preset, round(1000 * median(compute_time_s), 4) as ms
from trials where experiment = 'drives' group by map, preset order by map, preset
