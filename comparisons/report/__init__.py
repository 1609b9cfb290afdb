"""The report: one HTML page on how the solvers agree on the Caryatid, made from result files alone.

`study.make_results` simulates and writes the result files; `write.write_page` reads them and writes the page.

Studies appear in the page too: for every file in ``comparisons/results``, whose kind is a study's name, the section
that the `Study` makes of it (`comparisons.showing.parts`). A study draws from the result it is handed and from nothing
else, computes nothing new, and writes units into its column heads and axes. When the code behind a file has changed
since, the page says so.
"""
