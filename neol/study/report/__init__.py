"""Reports of the results: the page report.html, the paper reproduction.pdf and pages of docs/."""
