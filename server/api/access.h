// Who may use which resource.
#pragma once

#include "server/auth/tokens.h"
#include "server/http/options.h"

namespace server::api {

/// The gate of a server with tokens: 401 where a token is needed and none, or an unknown one, is there; 403
/// where the token does not allow what is asked. Names the bearer in Request::client. With `anonymous_read`,
/// reading needs no token. Without any token the gate is open: that is empty.
http::Gate make_gate(auth::Tokens tokens, bool anonymous_read);

}  // namespace server::api
