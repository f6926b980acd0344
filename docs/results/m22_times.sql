-- gapath experiment=m22
-- Medians over the trials of all scenes, whose runs m22.csv has one by one.
select preset, count(*) as trials, round(1000 * median(plan_time_s), 4) as ms,
  round(1000 * median((stage_times_s->>'dilation')::double), 4) as dilation_ms,
  round(1000 * median((stage_times_s->>'keypoints')::double), 4) as keypoints_ms,
  round(1000 * median((stage_times_s->>'graph')::double), 4) as graph_ms,
  round(1000 * median((stage_times_s->>'genetic algorithm')::double), 4) as genetic_ms,
  round(1000 * median((stage_times_s->>'search')::double), 4) as search_ms,
  round(1000 * median((stage_times_s->>'resizing')::double), 4) as resizing_ms
from trials where experiment = 'm22' group by preset order by preset
