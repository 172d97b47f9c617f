"""A report is data and one document: text, HTML and JSON come from it.

In come the answers of a check: a verdict, places, bounds, measures. A public report is a frozen dataclass of them and
has one method more, `document()`, which says in sentences what the data mean. Out go `str(report)`, a small table for
a notebook, and JSON by one schema of one version.

numbers.py   the one place where numbers are printed: values with errors, bounds, intervals, points, shares
words.py     parts of sentences: plurals, enumerations, boxes, letters
document.py  the verdict, sentences that are each proved or numerical, tables, entries
render.py    a document as text, as HTML, as JSON; the schema; `Report`, which gives a class all three

To add a report: a frozen dataclass that inherits `Report` and has `document()`, in the room whose answer it is; list it
in tests/reports/test_documents.py.
"""
