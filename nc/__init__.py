"""Control programs and the files of controls, read in one place.

`grammar` turns the text of Klartext and G-code into blocks, words, values and the order in which
blocks run. Two readers stand on it: that of our own probing programs, which refuses whatever it
does not expect (`matstd.probe_paths`), and that of a user's part programs, which keeps whatever
moves nothing (`matstd.compensation`). `linuxcnc` has the
files of that control: INI, HAL, variables and tools.
"""

PARTS = ("grammar", "linuxcnc")  # from bottom to top: each imports only from those before it
