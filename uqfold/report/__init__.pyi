from uqfold.report.comparison_page import write_figures as write_figures
from uqfold.report.page.builder import Page as Page
from uqfold.report.page.markup import literal as literal
from uqfold.report.reports import report_page as report_page, write_report as write_report
from uqfold.report.table import ComparisonTable as ComparisonTable
