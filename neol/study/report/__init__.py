"""What is told of the results: the page report.html and the paper reproduction.pdf."""
