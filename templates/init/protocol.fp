# A first protocol for the listed channels, to be changed: every number marked "to be set" is a placeholder.
#
#   fishplate check protocol.fp                   every error, with its place and the nearest right name
#   fishplate explain protocol.fp --stage needs   what a campaign must have, with units
#   fishplate fmt protocol.fp                     the canonical form
#
{%- if parent %}
# The protocol below is a variant: all rules of `{{ parent }}` hold, unless a block here has the name of one of them.
{%- else %}
# Each channel has one quantity: the rms value of the filtered signal in each section, simulated less measured. Take
# another value (median, p99.85, maximum), another filter, or another comparison (metric) where it serves better.
{%- endif %}

protocol {{ name }} "{{ title }}"
{%- if parent %}
  extends  {{ extends }}
{%- endif %}
  author   "To be stated"
  scope    "To be stated: for which vehicles, tests and uses of the model."
{%- if not parent %}
  axis     {{ axis.name }} in {{ axis.unit }}
{%- if time %}
  time     {{ time.name }} in {{ time.unit }}
{%- endif %}
{%- endif %}
{% if has_filter %}
parameter {{ cut_off }} "Cut-off frequency of the low-pass filter"
  default      20 Hz
  range        0.1 Hz to 1000 Hz
  unconfirmed  "To be set: a placeholder of the first draft."
{% endif %}
{%- for one in groups %}
# The limits of {{ one.title }}.

parameter {{ one.std_limit }} "Limit of the standard deviation of {{ one.title }}"
  default      1{{ one.number_unit }}
  unconfirmed  "To be set: a placeholder of the first draft."

parameter {{ one.mean_limit }} "Limit of the mean of {{ one.title }}"
  default      1{{ one.number_unit }}
  unconfirmed  "To be set: a placeholder of the first draft."
{% endfor %}
{%- for place in places %}
# The positions as they stand in the headers of the records.

place {{ place.name }}
  members  {{ place.members }}
{% endfor %}
{%- for one in groups %}
channel {{ one.name }} "{{ one.title }}"
  in      {{ one.unit }}
{%- if one.place %}
  at      each {{ one.place }}
{%- endif %}
  column  "{{ one.column }}"
{% endfor %}
{%- if has_filter %}
filter {{ filter }} "Low-pass filter"
  step  low-pass {{ cut_off }}, order 4, zero-phase
{% endif %}
{%- for one in groups %}
quantity {{ one.quantity }} "{{ one.title }}, rms value"
  of          {{ one.name }}
{%- if has_filter %}
  filter      {{ filter }}
{%- endif %}
  value       rms
  difference  simulated - measured
  limit       std {{ one.std_limit }}
  limit       mean {{ one.mean_limit }}
{% endfor %}
{%- if not parent %}
# Columns of the table of sections that a rule needs are declared so:
#
#   section speed "Speed"
#     in  km/h
#
# The model is validated if both limits of every quantity hold.

verdict
  validated  when every limit holds
{% endif %}
