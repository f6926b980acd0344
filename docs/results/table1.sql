-- gapath experiment=table1
-- Quartiles of epochs are of the trials that found a path; from_6, from_17 and from_30 are those that took so many or more.
select key, code, map, preset, count(*) as trials, sum(feasible::int) as found,
  round(quantile_cont(epochs, 0.25) filter (feasible and epochs > 0), 3) as epochs_q1,
  round(quantile_cont(epochs, 0.5) filter (feasible and epochs > 0), 3) as epochs,
  round(quantile_cont(epochs, 0.75) filter (feasible and epochs > 0), 3) as epochs_q3,
  round(quantile_cont(epochs, 0.025) filter (feasible and epochs > 0), 3) as epochs_low,
  round(quantile_cont(epochs, 0.975) filter (feasible and epochs > 0), 3) as epochs_high,
  count(*) filter (feasible and epochs >= 6) as from_6,
  count(*) filter (feasible and epochs >= 17) as from_17,
  count(*) filter (feasible and epochs >= 30) as from_30
from trials where experiment = 'table1'
group by key, code, map, preset order by map, preset
