"""An opponent of the verifier: shapes whose truth is known by construction, and the rules that judge a verdict."""
