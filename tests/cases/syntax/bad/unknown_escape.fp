protocol p "C:\models"
  note  "a \"quote\", a \\ and a break\n" "\t"
