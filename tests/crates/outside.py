"""Run by a Python of its own, which has roc-validator and runcrate: does each take a crate?

    python outside.py CRATE

Prints as JSON what does not fulfil the profile, how many checks there were, and how runcrate reads
the crate. Nothing is asked of a network: what the context of RO-Crate means comes from rocrate's
own files (of a newer version, in which all terms that are used mean the same), and the terms of
workflow runs stand here.
"""

import importlib.resources
import io
import json
import sys

import requests
from rocrate_validator import models, services
from rocrate_validator.utils.http import HttpRequester
from runcrate.report import dump_crate_actions

TERMS = "https://w3id.org/ro/terms/workflow-run"
CONTEXTS = {
    "https://w3id.org/ro/crate/1.1/context": json.loads(
        (importlib.resources.files("rocrate") / "data" / "ro-crate.jsonld").read_text("utf-8")
    ),
    f"{TERMS}/context": {
        "@context": {name: f"{TERMS}#{name}" for name in ("environment", "sha256")}
    },
}


def get(requester, url, **given):
    response = requests.Response()
    response.status_code, response.url = 200, url
    response.headers["Content-Type"] = "application/ld+json"
    response._content = json.dumps(CONTEXTS[url]).encode()
    return response


def main(crate):
    HttpRequester.get = get
    answer = {}
    for severity in ("REQUIRED", "RECOMMENDED"):
        settings = services.ValidationSettings(
            rocrate_uri=crate,
            profile_identifier="process-run-crate",
            requirement_severity=models.Severity[severity],
        )
        result = services.validate(settings)
        found = {
            f"{issue.severity.name} {issue.check.identifier}: {issue.message}"
            for issue in result.get_issues()
        }
        answer[severity] = {"issues": sorted(found), "checks": result.statistics.total_checks}
    said = io.StringIO()
    try:
        dump_crate_actions(crate, said)
    except Exception as error:  # it stumbles over crates that are no valid ones
        said.write(repr(error))
    print(json.dumps(answer | {"runcrate": said.getvalue()}))


if __name__ == "__main__":
    main(sys.argv[1])
