"""What a check of smoothness answers: places with their words, a verdict, sentences, the report.

In come places and the numbers of boxes that were found; out goes what follows from them, for people and programs.

report.py       continuities, places in the plane, the boxes of a proof, the report in the plane
singular.py     curves and points in space, each in a line of words; body_report.py the report in space
conclusions.py  the verdict, the order of places, sentences about the whole
account.py      that all that was found is in the report
"""
