"""The functions of the package: the operations, computed in this process."""

from service.dispatch import respond
from service.problems import Problem
from shapersmith.calls import Answered, Calls
from shapersmith.errors import raise_problem


class Here(Calls):
    """The operations, computed in this process."""

    def ask(self, answer: type[Answered], request: bytes) -> Answered:
        """Return the answer of the operation that HTTP and command line call.

        Parameters
        ----------
        answer, request
            Class of the answer, and the request as JSON.

        Returns
        -------
        Answered
            The answer.

        Raises
        ------
        ShapersmithError
            What HTTP answers as a problem document.
        """
        found = respond(answer.OPERATION, request)
        if isinstance(found, Problem):
            raise_problem(found.document())
        return answer.of(found, request)


HERE = Here()

design = HERE.design
recommend = HERE.recommend
maneuver = HERE.maneuver
simulate = HERE.simulate
run = HERE.run
sensitivity = HERE.sensitivity
fit = HERE.fit
field_map = HERE.field_map
