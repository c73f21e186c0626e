namespace pelorus {}
