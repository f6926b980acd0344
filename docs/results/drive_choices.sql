-- make choices
select key, code, map_instance as instance, method, reached, round(steps_ratio, 5) as steps_ratio
from trials where experiment = 'drive_choices' order by method, map_instance
