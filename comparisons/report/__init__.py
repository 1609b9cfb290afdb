"""The report: one HTML page on how the solvers agree on the Caryatid, made from result files alone.

`runs.make_results` simulates and writes the result files; `write.write_page` reads them and writes the page.

Studies appear in the page too. For every file ``comparisons/results/<study>.json`` (written with
`comparisons.running.provenance.write_result`, its kind being the study's name) the page looks for the module
``comparisons.studies.<study>`` (``-`` written ``_``) and shows what its function ::

    section(result: Result) -> Section

returns: a title, paragraphs of plain text, `Table`s and `Figure`s (see content.py; `figure_of` turns a matplotlib
figure into one). A study draws from the result it is handed and from nothing else, computes nothing
new, and writes units into its column heads and axes. When the code behind a file has changed since, the page says so.
"""
