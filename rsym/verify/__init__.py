"""Checks with an answer: proved where it can be, and called numerical where it is not.

In comes a shape with bounds and letters; out goes a report: a verdict, places and sentences, each proved or not.

1. What is asked: `smoothness` and `threshold`, for which `revolution`, `cleaning`, `angles` and `cells` write the
   formula so that boxes can decide it. Beside it normalisation/ and, of given curves, continuity/.
2. boxes/ says what one box holds, and what is missing where nothing is proved; points/ what a point is, curves/ where
   sheets meet; cover/ asks them of all boxes.
3. `plane` and `bodies` put together what was found; `everywhere` and `fibres` speak of letters that range in space.
4. What follows: answers/ has the verdict and its sentences, the places, and the account that nothing was lost.
5. What asks for more: fairness/, repair/, atlas/ and lint/.
"""
