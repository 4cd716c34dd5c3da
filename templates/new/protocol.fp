# A first protocol for the records of this campaign. The limits are a tenth of what was measured: placeholders, to be set.

protocol {{ name }}-protocol "Protocol of {{ title }}"
  author  "To be stated"
  scope   "To be stated: for which machines, tests and uses of the model."
  axis    {{ axis.name }} in {{ axis.unit }}
{%- if time %}
  time    {{ time.name }} in {{ time.unit }}
{%- endif %}
{% for channel in channels %}
channel {{ channel.id }} "{{ channel.title }}"
  in      {{ channel.unit }}
  column  "{{ channel.name }}"
{% endfor %}
filter LP "Low-pass filter above the content of the records"
  step  low-pass {{ highest }} Hz, order 2, zero-phase, as-applied
{% for channel in channels %}
parameter {{ channel.id }}_limit "Limit of {{ channel.title }}"
  default      {{ channel.limit }}{{ channel.number_unit }}
  unconfirmed  "To be set: a tenth of the measured rms value."

quantity {{ channel.id }}_rms "{{ channel.title }}, rms value"
  of          {{ channel.id }}
  filter      LP
  value       rms
  difference  simulated - measured
  limit       std {{ channel.id }}_limit
  limit       mean {{ channel.id }}_limit

quantity {{ channel.id }}_high "{{ channel.title }}, 97.5 % value"
  of          {{ channel.id }}
  filter      LP
  value       p97.5
  difference  simulated - measured
  limit       std 2 * {{ channel.id }}_limit
  limit       mean 2 * {{ channel.id }}_limit
{% endfor %}
verdict
  validated  when every limit holds
