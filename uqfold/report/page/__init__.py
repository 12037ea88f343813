"""Pages: a report told step by step, written as Markdown or as one HTML file.

All text in them is text: nothing that it holds can become markup or code of the report.
"""
