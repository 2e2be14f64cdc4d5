"""A run reduced to what the error of any set of effects follows from, without its touches.

In: a `Diagnosis` or a `Comparison`. Out: a `Board`: effects to switch (`Switch`), and matrices
(`Reduced`) of which fitted and held-out error of every set follow, as a fit to the touches gives
them; geometry and set-ups are refitted each time. Live pages evaluate them in the browser.
"""

from matstd.diagnosis.reduced.board import Board as Board
from matstd.diagnosis.reduced.board import compared_board as compared_board
from matstd.diagnosis.reduced.board import diagnosed_board as diagnosed_board
from matstd.diagnosis.reduced.board import learnt_board as learnt_board
from matstd.diagnosis.reduced.matrices import Matrices as Matrices
from matstd.diagnosis.reduced.switches import Switch as Switch
