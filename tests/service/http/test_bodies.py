"""Whose request it is."""

import pytest

from service.http.bodies import client_of


@pytest.mark.parametrize(
    ("host", "client"),
    [
        ("192.0.2.7", "192.0.2.7"),
        ("2001:db8:1:2:3:4:5:6", "2001:db8:1:2::/64"),
        ("2001:db8:1:2::1", "2001:db8:1:2::/64"),
        ("fe80::1%eth0", "fe80::/64"),
        ("a:name", "a:name"),
    ],
)
def test_a_client_is_an_address_or_a_network_of_one_machine(host: str, client: str) -> None:
    assert client_of({"type": "http", "client": (host, 1)}) == client


def test_who_comes_by_a_socket_file_has_no_address() -> None:
    assert client_of({"type": "http", "client": None}) == ""
