"""The paper's environments in compiled code, with Gymnasium's bits."""
