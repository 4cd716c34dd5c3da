protocol found-data-in-a-circle "Section data that need each other"
  extends  en14363-2016-annex-t-found-sections

section cant
  found  cant_deficiency

section cant_deficiency
  found  cant
