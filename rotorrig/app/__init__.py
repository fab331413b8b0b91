"""User interface: command line, terminal output, HTML report and Rerun viewer. Nothing imports app.

`verbs` parse the command line, `commands` do what a verb asks, `text` and `terminal` put results into words and tables,
`plot_data` computes what plots show, `report` writes HTML, `viewer` feeds Rerun.
"""
