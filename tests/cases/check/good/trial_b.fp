protocol kraft_share "Misfit over the sections against a quality indicator, after Kraft et al."
  extends  en14363-2016-annex-t

remove
  quantity  every

parameter mqi "Model quality indicator, from repeated runs"
  default  0.3
  range    0 to 100

estimate share_within "Share of the values within the quality indicator"
  is  share where value <= mqi

quantity misfit_{signal} "{signal}: least-squares misfit"
  for each  signal in Y, Q
  of        {signal} at wheelsets 1, 3
  filter    LP20
  metric    misfit
  limit     share_within at least 80 %
  limit     p80 2 * mqi
  limit     p95 4 * mqi
  limit     median mqi for each zone
