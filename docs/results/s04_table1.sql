-- gapath experiment=s04_table1
-- Runs of every generation and runs that end at their first path are the same up to there; once: of the former, those whose like among the latter found a path.
with first as (
  select map, preset, seed, trial, feasible from trials
  where experiment = 's04_table1' and planner.stop_when_feasible)
select key, code, map, preset, planner.stop_when_feasible as ends_at_first, count(*) as trials,
  sum(trials.feasible::int) as found, sum(first.feasible::int) as once,
  count(*) filter (first.feasible and not trials.feasible) as lost
from trials left join first using (map, preset, seed, trial) where experiment = 's04_table1'
group by key, code, map, preset, planner.stop_when_feasible order by map, preset, ends_at_first
