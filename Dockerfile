# An image to grade strangers' notebooks in; docs/teaching.md says how, and what it does not guard.
FROM python:3.12-slim

WORKDIR /course
COPY pyproject.toml README.md LICENSE LICENSE-notes ./
COPY tools/package_page.py tools/package_page.py
COPY cvnotes cvnotes
COPY notebooks notebooks
COPY data data
RUN pip install --no-cache-dir --editable .

# Whoever runs it says as whom: docker run --user "$(id -u):$(id -g)" …
ENV HOME=/tmp
WORKDIR /work
ENTRYPOINT ["cvnotes"]
